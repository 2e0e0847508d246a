"""Terminal input and output: tables, progress, interruption, and the lines that end a command."""
