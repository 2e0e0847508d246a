"""CalculiX and the forms of this project on a bar."""
