//! Floor 12: names become boxes, cases become models, models become results.
