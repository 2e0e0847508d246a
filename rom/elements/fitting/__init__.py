"""Elements from training states: samples in, laws with their errors out."""
