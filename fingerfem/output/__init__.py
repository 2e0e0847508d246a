"""What people look at: files for ParaView, pictures, rows."""
