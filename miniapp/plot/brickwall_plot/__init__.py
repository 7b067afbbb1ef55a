"""Pictures, animations and plots of Brickwall's results; see README.md beside this folder."""
