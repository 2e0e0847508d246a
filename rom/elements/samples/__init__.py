"""From full-order states to samples of elements: sections, cuts, images, and the combinations of tensions."""
