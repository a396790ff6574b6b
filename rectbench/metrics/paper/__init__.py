"""What Zhou, Dai and Li measure or claim, so measured that it can be refuted. Imports metrics and below."""
