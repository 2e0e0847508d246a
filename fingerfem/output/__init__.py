"""Output for people: files for ParaView, pictures, rows."""
