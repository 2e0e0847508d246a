"""What others take from rest to a tension and along a contact line."""
