//! A hundred things made wrong at random: the first named cause is the true one.
