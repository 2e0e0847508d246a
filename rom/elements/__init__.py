"""Rod elements: short pieces of a finger, each a polynomial of tensions and the wrench that it transmits."""
