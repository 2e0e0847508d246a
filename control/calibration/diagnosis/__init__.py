"""What a calibration says of its log: outliers, what no parameter explains, what the log does not determine."""
