"""The paper's own method: answers before one object, sampled on a tensor grid and separated (equations 2 and 3)."""
