"""Files: whole when written, checked when read, with a kind each."""
