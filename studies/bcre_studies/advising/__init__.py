"""What ``bcre advise`` does: questions, pilots, candidates, the answer and its trial."""
