"""Lines of states, a module a kind: which tasks must be done before, how it is solved, what is left of one given up.

The result of a task depends on the set's description and on the files of tasks before it alone.
"""
