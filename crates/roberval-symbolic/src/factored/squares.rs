//! Squares of sums in polynomials of second degree: `y2^2 + 2 y2 y3 + y3^2` is `(y2 + y3)^2`.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

use crate::polynomial::Monomial;

/// A number times powers of variables.
type Term = (BigInt, Monomial);

/// Variables, and the terms in which they are tied together.
type Group = (Vec<usize>, Vec<Term>);

/// A number times the square of a sum of variables.
pub(super) type Square = (BigInt, Vec<(BigInt, usize)>);

/// Takes squares of sums of variables out of terms of second degree: those that products of
/// two variables tie together and that are one square.
pub(super) fn with_squares(terms: Vec<Term>) -> (Vec<Square>, Vec<Term>) {
    let of = |m: &Monomial| -> Vec<usize> { (0..m.len()).filter(|&k| m[k] > 0).collect() };
    let mut groups: Vec<Group> = Vec::new();
    for term in terms {
        let mut variables = of(&term.1);
        let mut members = vec![term];
        let tied = |group: &Group| group.0.iter().any(|v| variables.contains(v));
        let (ties, rest): (Vec<_>, Vec<_>) = groups.into_iter().partition(tied);
        for (more, others) in ties {
            variables.extend(more);
            members.extend(others);
        }
        variables.sort_unstable();
        variables.dedup();
        groups = rest;
        groups.push((variables, members));
    }
    let (mut squares, mut others) = (Vec::new(), Vec::new());
    for (variables, members) in groups {
        match square(&variables, &members) {
            Some(square) => squares.push(square),
            None => others.extend(members),
        }
    }
    (squares, others)
}

/// The square that terms in these variables are, two at least.
fn square(variables: &[usize], terms: &[Term]) -> Option<Square> {
    let count = variables.len();
    if count < 2 || terms.len() != count * (count + 1) / 2 {
        return None;
    }
    let coefficient = |i: usize, j: usize| {
        let is = |m: &Monomial| {
            let exponents = variables.iter().map(|&k| m[k]);
            let expected = variables
                .iter()
                .map(|&k| u8::from(k == i) + u8::from(k == j));
            exponents.eq(expected)
        };
        terms.iter().find(|(_, m)| is(m)).map(|(c, _)| c.clone())
    };
    let mut number = BigInt::zero();
    for &k in variables {
        number = number.gcd(&coefficient(k, k)?);
    }
    if coefficient(variables[0], variables[0])?.is_negative() {
        number = -number;
    }
    let mut sum: Vec<(BigInt, usize)> = Vec::new();
    for &k in variables {
        let square = coefficient(k, k)? / &number;
        let root = (!square.is_negative()).then(|| square.sqrt())?;
        if &root * &root != square {
            return None;
        }
        let sign = match sum.first() {
            Some((_, first)) => (coefficient(*first, k)? * number.signum()).signum(),
            None => BigInt::one(),
        };
        sum.push((root * sign, k));
    }
    for (at, (a, i)) in sum.iter().enumerate() {
        for (b, j) in &sum[at + 1..] {
            if coefficient(*i, *j)? != BigInt::from(2) * &number * a * b {
                return None;
            }
        }
    }
    Some((number, sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(list: &[(i64, [u8; 3])]) -> Vec<Term> {
        let term = |(c, m): &(i64, [u8; 3])| (BigInt::from(*c), m.to_vec());
        list.iter().map(term).collect()
    }

    #[test]
    fn squares_of_sums_and_differences_are_found_beside_other_terms() {
        // -2 (x - 3 y)^2 + z^2
        let list = terms(&[
            (-2, [2, 0, 0]),
            (12, [1, 1, 0]),
            (-18, [0, 2, 0]),
            (1, [0, 0, 2]),
        ]);
        let (squares, others) = with_squares(list);
        let sum = vec![(BigInt::from(1), 0), (BigInt::from(-3), 1)];
        assert_eq!(squares, [(BigInt::from(-2), sum)]);
        assert_eq!(others, terms(&[(1, [0, 0, 2])]));
    }

    #[test]
    fn what_is_no_square_stays_as_it_is() {
        for list in [
            terms(&[(1, [2, 0, 0]), (1, [1, 1, 0]), (1, [0, 2, 0])]),
            terms(&[(1, [2, 0, 0]), (2, [1, 1, 0]), (-1, [0, 2, 0])]),
            terms(&[(1, [2, 0, 0]), (2, [1, 1, 0])]),
            terms(&[(1, [1, 0, 0]), (1, [0, 1, 0])]),
        ] {
            let (squares, others) = with_squares(list.clone());
            assert!(squares.is_empty());
            assert_eq!(others.len(), list.len());
        }
    }
}
