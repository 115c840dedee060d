//! The window in a browser.
fn main() {}
