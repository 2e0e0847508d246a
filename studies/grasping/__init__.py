"""Fingers in MuJoCo pick up, lift, turn and put down what stands on a table."""
