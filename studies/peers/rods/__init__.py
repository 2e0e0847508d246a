"""What is taken for soft robots in place of finite elements."""
