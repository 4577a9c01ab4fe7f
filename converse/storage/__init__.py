"""Files that are either whole or as they were before, and the backup of a run."""
