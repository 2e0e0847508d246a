"""What people read and type: tables, progress, interruption, and the lines that end a command."""
