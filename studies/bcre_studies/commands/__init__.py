"""The commands, a file each; heavy modules are imported when a command needs them."""
