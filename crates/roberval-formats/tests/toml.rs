//! Robot TOML and the catalogue.

use roberval_formats::{catalogue, load, parse_toml, to_toml};

#[test]
fn every_built_in_robot_loads_and_round_trips() {
    for entry in catalogue() {
        let robot = load(entry.name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!entry.source.is_empty() && !entry.title.is_empty());
        assert_eq!(robot.warnings, Vec::<String>::new(), "{}", entry.name);
        let text = to_toml(&robot).unwrap();
        assert_eq!(parse_toml(&text, "again").unwrap(), robot, "{text}");
    }
}
