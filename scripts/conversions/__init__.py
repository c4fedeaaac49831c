"""Every pair of formats and objects: what clouds keep on their way through both."""
