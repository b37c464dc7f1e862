//! JSON with one short value a line: readable, and small for wide robots.

use serde_json::Value;

use crate::escape::is_hidden;

/// Values up to this many characters stand on one line.
const LINE: usize = 96;

/// JSON, indented, every short value on one line, a line end at the end. What a terminal
/// or JavaScript would take for more than text (U+2028, bidirectional controls) is escaped.
pub(crate) fn pretty(value: &Value) -> String {
    let mut json = String::new();
    write(value, 0, &mut json);
    json.push('\n');
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        // All hidden characters lie in the basic plane: four digits are enough.
        match c {
            '\n' => out.push(c),
            c if is_hidden(c) => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}

fn write(value: &Value, indent: usize, out: &mut String) {
    let flat = value.to_string();
    let (open, close, children): (char, char, Vec<(String, &Value)>) = match value {
        Value::Array(items) if flat.len() > LINE => {
            ('[', ']', items.iter().map(|v| (String::new(), v)).collect())
        }
        Value::Object(map) if flat.len() > LINE => {
            let key = |k: &String| format!("{}: ", Value::from(k.as_str()));
            ('{', '}', map.iter().map(|(k, v)| (key(k), v)).collect())
        }
        _ => return out.push_str(&flat),
    };
    out.push(open);
    for (i, (key, child)) in children.into_iter().enumerate() {
        out.push_str(if i == 0 { "\n" } else { ",\n" });
        out.push_str(&" ".repeat(indent + 1));
        out.push_str(&key);
        write(child, indent + 1, out);
    }
    out.push('\n');
    out.push_str(&" ".repeat(indent));
    out.push(close);
}
