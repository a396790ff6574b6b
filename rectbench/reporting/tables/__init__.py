"""Tables of a run, and how they are spelt. Imports runs, plugins and names; starts from charts."""
