"""Description of a model: the tables of a scene, their rules, and quantities from these alone."""
