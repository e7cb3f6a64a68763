"""Study: how fast roughness decays."""
