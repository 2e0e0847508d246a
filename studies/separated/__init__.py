"""The study of docs/separated.md."""
