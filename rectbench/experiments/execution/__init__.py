"""Cells run in worker processes that can crash, hang or swallow memory alone. Imports plans and tasks."""
