"""û = h(β, γ), v̂ = g(β): maps of what a lens sees whose rows are epipolar planes, at any angle."""
