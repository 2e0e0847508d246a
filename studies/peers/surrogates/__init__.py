"""Other packages' surrogates, trained on the same states as this project's."""
