"""What studies measure with: observed quantities, outcomes, closed forms beside them."""
