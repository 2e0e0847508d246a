"""A segment of rubber condensed to its plate: tensions and the wrench on the plate -> where the plate is.

(A nonlinear superelement.) Contact is not in it: whatever touches the plate presses on it with some wrench, and is
solved for by rigid-body geometry (`touched_segment`, native/touch.c).
"""
