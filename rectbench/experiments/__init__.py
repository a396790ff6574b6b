"""Reports, their plans and cells; claims, the gate, comparisons."""
