"""The search for a proof: the C core, the tree of prisms, who does the work, and the report."""
