"""A finger assembled from rod elements."""
