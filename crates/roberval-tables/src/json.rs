//! JSON with one short value a line: readable, and small for wide robots.

use serde_json::Value;

/// Values up to this many characters stand on one line.
const LINE: usize = 96;

/// JSON, indented, every short value on one line; U+2028 and U+2029 escaped for
/// JavaScript; a line end at the end.
pub(crate) fn pretty(value: &Value) -> String {
    let mut out = String::new();
    write(value, 0, &mut out);
    out.push('\n');
    out.replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
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
