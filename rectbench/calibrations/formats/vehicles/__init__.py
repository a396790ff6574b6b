"""Cars and their simulators: NVIDIA's f-theta rigs, WoodScape, nuScenes, Argoverse."""
