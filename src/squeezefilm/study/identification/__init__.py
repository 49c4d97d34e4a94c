"""Statistics of identification: confusions, information, d′, intervals over participants."""
