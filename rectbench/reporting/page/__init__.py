"""The page of a run, and what it says about the run itself. Imports all of reporting but `report`."""
