"""What a run answers: results, intervals, findings, numbers of bolts."""
