//! A dense matrix of `f64`, stored column by column.

use std::fmt;
use std::ops::{Index, IndexMut};

use crate::LinalgError;
use crate::scale::{largest_magnitude, norm_parts, times_power_of_two};

/// A dense `rows` x `cols` matrix, column-major; either size may be 0.
#[derive(Clone, PartialEq, Default)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// The `rows` x `cols` zero matrix.
    ///
    /// # Panics
    /// If `rows * cols` does not fit in `usize`.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        let size = rows.checked_mul(cols).expect("matrix size fits in usize");
        Matrix {
            rows,
            cols,
            data: vec![0.0; size],
        }
    }

    /// The `n` x `n` identity.
    pub fn identity(n: usize) -> Self {
        Matrix::from_fn(n, n, |i, j| f64::from(i == j))
    }

    /// The matrix with entries `entry(i, j)`.
    pub fn from_fn(rows: usize, cols: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        let mut matrix = Matrix::zeros(rows, cols);
        for j in 0..cols {
            for (i, x) in matrix.col_mut(j).iter_mut().enumerate() {
                *x = entry(i, j);
            }
        }
        matrix
    }

    /// The matrix whose entries come row by row.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] unless there are `rows * cols` entries.
    pub fn from_row_major(rows: usize, cols: usize, entries: &[f64]) -> Result<Self, LinalgError> {
        if rows.checked_mul(cols) != Some(entries.len()) {
            return Err(LinalgError::Shape {
                what: "row-major entries",
                expected: format!("{rows} x {cols} entries"),
                found: format!("{} entries", entries.len()),
            });
        }
        Ok(Matrix::from_fn(rows, cols, |i, j| entries[i * cols + j]))
    }

    /// The matrix with the given columns, all of `rows` entries.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] if a column has another length.
    pub fn from_columns<C: AsRef<[f64]>>(rows: usize, columns: &[C]) -> Result<Self, LinalgError> {
        let mut matrix = Matrix::zeros(rows, columns.len());
        for (j, column) in columns.iter().enumerate() {
            let column = column.as_ref();
            if column.len() != rows {
                return Err(LinalgError::Shape {
                    what: "columns of a matrix",
                    expected: format!("{rows} entries in column {j}"),
                    found: format!("{} entries", column.len()),
                });
            }
            matrix.col_mut(j).copy_from_slice(column);
        }
        Ok(matrix)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Column `j`, `rows` entries.
    ///
    /// # Panics
    /// If there is no column `j`.
    pub fn col(&self, j: usize) -> &[f64] {
        assert!(
            j < self.cols,
            "column {j} of a {} x {} matrix",
            self.rows,
            self.cols
        );
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Column `j` to write to.
    ///
    /// # Panics
    /// If there is no column `j`.
    pub fn col_mut(&mut self, j: usize) -> &mut [f64] {
        assert!(
            j < self.cols,
            "column {j} of a {} x {} matrix",
            self.rows,
            self.cols
        );
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// All entries, column by column.
    pub fn as_slice(&self) -> &[f64] {
        &self.data
    }

    /// All entries to write to, column by column.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.data
    }

    /// The columns `columns`, in that order.
    ///
    /// # Panics
    /// If one of them does not exist.
    pub fn select_columns(&self, columns: &[usize]) -> Self {
        let mut selected = Matrix::zeros(self.rows, columns.len());
        for (k, &j) in columns.iter().enumerate() {
            selected.col_mut(k).copy_from_slice(self.col(j));
        }
        selected
    }

    /// The rows `rows`, in that order.
    ///
    /// # Panics
    /// If one of them does not exist.
    pub fn select_rows(&self, rows: &[usize]) -> Self {
        Matrix::from_fn(rows.len(), self.cols, |i, j| self[(rows[i], j)])
    }

    /// The transposed matrix.
    pub fn transpose(&self) -> Self {
        Matrix::from_fn(self.cols, self.rows, |i, j| self[(j, i)])
    }

    /// The product `self * other`.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] unless `self.cols() == other.rows()`.
    pub fn matmul(&self, other: &Matrix) -> Result<Self, LinalgError> {
        if self.cols != other.rows {
            return Err(LinalgError::Shape {
                what: "matrix product",
                expected: format!("{} rows on the right", self.cols),
                found: format!("{} rows", other.rows),
            });
        }
        let mut product = Matrix::zeros(self.rows, other.cols);
        for j in 0..other.cols {
            self.add_product(other.col(j), product.col_mut(j));
        }
        Ok(product)
    }

    /// `y += self * x`, over the columns of `self`.
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (k, &factor) in x.iter().enumerate() {
            if factor != 0.0 {
                for (y, &a) in y.iter_mut().zip(self.col(k)) {
                    *y += a * factor;
                }
            }
        }
    }

    /// The largest magnitude of an entry; 0 for an empty matrix, NaN if an entry is NaN.
    pub fn max_abs(&self) -> f64 {
        largest_magnitude(&self.data)
    }

    /// The Frobenius norm, scaled inside: infinite only if the norm itself is above the largest double.
    pub fn frobenius_norm(&self) -> f64 {
        let (fraction, exponent) = norm_parts(&self.data);
        times_power_of_two(fraction, exponent)
    }

    /// The 2-norm of column `j`, scaled inside like [`Matrix::frobenius_norm`].
    ///
    /// # Panics
    /// If there is no column `j`.
    pub fn column_norm(&self, j: usize) -> f64 {
        let (fraction, exponent) = norm_parts(self.col(j));
        times_power_of_two(fraction, exponent)
    }

    /// Refuses NaN and infinities.
    ///
    /// # Errors
    /// [`LinalgError::NotFinite`] with the row and column of the first bad entry, column by column.
    pub fn check_finite(&self) -> Result<(), LinalgError> {
        match self.data.iter().position(|x| !x.is_finite()) {
            None => Ok(()),
            Some(k) => Err(LinalgError::NotFinite {
                row: k % self.rows,
                col: k / self.rows,
                value: self.data[k],
            }),
        }
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.col(j)[i]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.col_mut(j)[i]
    }
}

impl fmt::Debug for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} x {}", self.rows, self.cols)?;
        for i in 0..self.rows.min(20) {
            for j in 0..self.cols.min(12) {
                write!(f, "{:12.4e}", self[(i, j)])?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
