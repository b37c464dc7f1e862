//! States from NPZ: a ZIP archive with the arrays q, qd and qdd.

use std::fs::File;
use std::io::{BufReader, Read};

use roberval_base::Model;
use roberval_mechanism::Mechanism;
use zip::ZipArchive;
use zip::read::ZipFile;

use super::npy::Header;
use super::{ARRAYS, StateTable, needed, some, width};

/// Deflate packs at most 1032 bytes into one: an array that claims more of its packed
/// bytes is not there.
const DEFLATE_LIMIT: u64 = 1032;

/// More bytes of states than this are refused.
const MOST_BYTES: u64 = 8 << 30;

type Archive = ZipArchive<BufReader<File>>;

/// Reads the arrays that the model needs.
pub(super) fn read(
    file: File,
    mechanism: &Mechanism,
    model: Model,
    note: &mut dyn FnMut(String),
) -> Result<StateTable, String> {
    let mut archive = ZipArchive::new(BufReader::new(file))
        .map_err(|e| format!("the archive is damaged or cut off: {e}"))?;
    let needed = needed(model);
    let names: Vec<String> = archive
        .file_names()
        .map(|name| name.map(|name| array_name(&name)))
        .collect::<Result<_, _>>()
        .map_err(|e| format!("the archive is damaged: {e}"))?;
    check_names(&names, needed, note)?;
    let mut count = None;
    let mut arrays: [Vec<f64>; 3] = Default::default();
    for (at, name) in ARRAYS.into_iter().enumerate() {
        if needed[at] {
            let (found, numbers) = read_array(&mut archive, name, width(mechanism, at))
                .map_err(|what| format!("array {name}: {what}"))?;
            check_count(name, found, *count.get_or_insert(found))?;
            arrays[at] = numbers;
        }
    }
    let count = count.unwrap_or(0);
    for (at, array) in arrays.iter_mut().enumerate() {
        array.resize(count * width(mechanism, at), 0.0);
    }
    let [q, qd, qdd] = arrays;
    Ok(StateTable { q, qd, qdd, count })
}

fn array_name(file: &str) -> String {
    file.strip_suffix(".npy").unwrap_or(file).to_owned()
}

fn check_names(
    names: &[String],
    needed: [bool; 3],
    note: &mut dyn FnMut(String),
) -> Result<(), String> {
    let has = |name: &str| names.iter().any(|n| n == name);
    for (name, _) in ARRAYS.iter().zip(needed).filter(|(_, needed)| *needed) {
        if !has(name) {
            return Err(format!(
                "there is no array {name}; the file has {}",
                if names.is_empty() {
                    "no array".to_owned()
                } else {
                    some(names)
                }
            ));
        }
    }
    let unused: Vec<String> = names
        .iter()
        .filter(|n| !ARRAYS.contains(&n.as_str()))
        .cloned()
        .collect();
    if !unused.is_empty() {
        note(format!("arrays that are not used: {}", some(&unused)));
    }
    Ok(())
}

fn check_count(name: &str, found: usize, expected: usize) -> Result<(), String> {
    if found == 0 {
        return Err(format!("array {name} has no state"));
    }
    if found != expected {
        return Err(format!(
            "array {name} has {found} states, but q has {expected}"
        ));
    }
    Ok(())
}

/// The number of states and the numbers, N x n in C order, all finite.
fn read_array(archive: &mut Archive, name: &str, dof: usize) -> Result<(usize, Vec<f64>), String> {
    let mut file = archive
        .by_name(&format!("{name}.npy"))
        .map_err(|e| format!("cannot be read: {e}"))?;
    let header = Header::read(&mut file)?;
    let [count, width] = header.shape[..] else {
        return Err(wrong_shape(&header, dof));
    };
    if width != dof {
        return Err(wrong_shape(&header, dof));
    }
    let bytes = read_bytes(&mut file, &header)?;
    let numbers = header.numbers(&bytes);
    if let Some(at) = numbers.iter().position(|x| !x.is_finite()) {
        return Err(format!(
            "the entry [{}, {}] is {}: joint states must be finite numbers",
            at / dof,
            at % dof,
            numbers[at]
        ));
    }
    Ok((count, numbers))
}

fn wrong_shape(header: &Header, dof: usize) -> String {
    let shape: Vec<String> = header.shape.iter().map(ToString::to_string).collect();
    format!(
        "its shape is ({}), expected (N, {dof}): a row a state, a column a joint",
        shape.join(", ")
    )
}

/// The array's bytes. Memory grows with what is really there, never with what the header
/// claims.
fn read_bytes(file: &mut ZipFile<'_, BufReader<File>>, header: &Header) -> Result<Vec<u8>, String> {
    let most = file.compressed_size().saturating_mul(DEFLATE_LIMIT);
    let claimed = header.bytes().filter(|bytes| *bytes <= most);
    let Some(claimed) = claimed else {
        return Err("its header claims more numbers than the file can hold".to_owned());
    };
    if claimed > MOST_BYTES {
        let most = MOST_BYTES >> 30;
        return Err(format!("it has more than {most} GiB: split the file"));
    }
    let mut bytes = Vec::new();
    file.take(claimed + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| format!("its numbers are damaged or cut off: {e}"))?;
    match (bytes.len() as u64).cmp(&claimed) {
        std::cmp::Ordering::Less => Err(format!(
            "it is cut off: {} of {claimed} bytes are there",
            bytes.len()
        )),
        std::cmp::Ordering::Greater => Err("it has more numbers than its shape says".to_owned()),
        std::cmp::Ordering::Equal => Ok(bytes),
    }
}
