"""What acts on the finger: actuators, weight, and wrenches on its plates."""
