"""Contacts in MuJoCo: those of rubber as the rod has them, and friction by Coulomb's law."""
