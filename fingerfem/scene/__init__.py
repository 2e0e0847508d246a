"""What is modelled: the tables of a scene, their rules, and what follows from them alone."""
