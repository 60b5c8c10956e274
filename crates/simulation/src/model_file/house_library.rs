//! The houses of the laboratory, ready to be taken: `[[house]] type = "SF1"`.
//!
//! Each is a `[house_type.NAME]` as a model file would have it (`crates/simulation/houses`), so its text can be copied into a model
//! and changed there. **Sources** `zinsmeister2023`, `prohmo`; what is assumed is said in `docs/src/houses.md`.

/// Names and texts, in the order of the laboratory.
pub const HOUSES: [(&str, &str); 5] = [
    ("SF1", include_str!("../../houses/SF1.toml")),
    ("SF2", include_str!("../../houses/SF2.toml")),
    ("SF3", include_str!("../../houses/SF3.toml")),
    ("SF4", include_str!("../../houses/SF4.toml")),
    ("MF5", include_str!("../../houses/MF5.toml")),
];

/// The text of a house.
pub fn text(name: &str) -> Option<&'static str> {
    HOUSES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
