# Recipes for work on roberval; `just` lists them.

# List the recipes.
default:
    @just --list

# Build the extension into the active virtual environment, with what the tests need.
develop:
    maturin develop --release --extras test,peers

# Rust's tests.
test-rust *arguments:
    cargo test --workspace {{arguments}}

# Python's tests, against what `just develop` built.
test-python *arguments:
    python -m pytest tests README.md docs --pyargs roberval {{arguments}}

# Format everything.
format:
    cargo fmt --all
    ruff check --fix .
    ruff format .

# The lints.
lint:
    cargo clippy --workspace --all-targets -- -D warnings
    ruff check .
    mypy

# Everything, as CI does.
check:
    ./check
