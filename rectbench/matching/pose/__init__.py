"""The relative pose that matches determine."""
