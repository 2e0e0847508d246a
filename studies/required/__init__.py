"""What each kind of scene costs: docs/required.md."""
