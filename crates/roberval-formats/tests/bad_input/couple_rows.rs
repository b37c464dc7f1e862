use super::Row;

/// What follows the revolute links "a" (lines 3 to 7), "b" and the fixed link "c"; the
/// first row begins in line 19.
pub const COUPLES: &[Row] = &[
    (
        "couple of nothing",
        "[[couple]]\n",
        "E132",
        &["r.toml:19:1", "couple 1", "joint is missing"],
    ),
    (
        "couple without terms",
        "[[couple]]\njoint = \"b\"\n",
        "E132",
        &["r.toml:19:1", "couple of joint \"b\"", "equals is missing"],
    ),
    (
        "couple with no joint to follow",
        "[[couple]]\njoint = \"b\"\nequals = {}\n",
        "E211",
        &["r.toml:21:1", "\"b\"", "names no joint to follow"],
    ),
    (
        "unknown key",
        "[[couple]]\njoint = \"b\"\nequal = { \"a\" = 1 }\n",
        "E130",
        &["r.toml:21:1", "did you mean equals?"],
    ),
    (
        "couple of an unknown joint",
        "[[couple]]\njoint = \"B1\"\nequals = { \"a\" = 1 }\n",
        "E231",
        &["r.toml:20:1", "\"B1\"", "did you mean \"b\"?"],
    ),
    (
        "couple to an unknown joint",
        "[[couple]]\njoint = \"b\"\nequals = { \"aa\" = 1 }\n",
        "E231",
        &["r.toml:21:1", "\"aa\"", "did you mean \"a\"?"],
    ),
    (
        "couple of a fixed joint",
        "[[couple]]\njoint = \"c\"\nequals = { \"a\" = 1 }\n",
        "E211",
        &["r.toml:20:1", "\"c\"", "fixed"],
    ),
    (
        "couple to a fixed joint",
        "[[couple]]\njoint = \"b\"\nequals = { \"c\" = 1 }\n",
        "E211",
        &["r.toml:21:1", "\"c\"", "fixed"],
    ),
    (
        "couple to itself",
        "[[couple]]\njoint = \"b\"\nequals = { \"b\" = 2 }\n",
        "E230",
        &[
            "r.toml:21:1",
            "circle: \"b\" from \"b\"",
            "must move by itself",
        ],
    ),
    (
        "couples in a circle",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = 2 }\n[[couple]]\njoint = \"a\"\nequals = { \"b\" = 1 }\n",
        "E230",
        &["r.toml:21:1", "\"b\" from \"a\" from \"b\""],
    ),
    (
        "two couples of one joint",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = 2 }\n[[couple]]\njoint = \"b\"\nequals = { \"a\" = 1 }\n",
        "E211",
        &[
            "r.toml:23:1",
            "two couples (numbers 1 and 2)",
            "begins in line 19",
        ],
    ),
    (
        "multiplier 0",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = 0 }\n",
        "E211",
        &["r.toml:21:1", "multiplier 0", "make it fixed"],
    ),
    (
        "multiplier with a word",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = \"twice\" }\n",
        "E220",
        &["r.toml:21:19", "\"twice\""],
    ),
    (
        "multiplier of no kind",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = true }\n",
        "E131",
        &["r.toml:21:", "a must be a number"],
    ),
    (
        "multiplier beyond doubles",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = \"1e300*1e300\" }\n",
        "E240",
        &["r.toml:21:"],
    ),
    (
        "offset of no kind",
        "[[couple]]\njoint = \"b\"\nequals = { \"a\" = 1 }\noffset = [1]\n",
        "E131",
        &["r.toml:22:1", "offset"],
    ),
    (
        "terms of no kind",
        "[[couple]]\njoint = \"b\"\nequals = \"a\"\n",
        "E131",
        &["r.toml:21:1", "equals must be a table"],
    ),
    (
        "expression and terms",
        "[[couple]]\njoint = \"b\"\nexpression = \"2*q.a\"\nequals = { \"a\" = 1 }\n",
        "E211",
        &["r.toml:22:1", "not both"],
    ),
    (
        "expression without joints",
        "[[couple]]\njoint = \"b\"\nexpression = \"pi/2\"\n",
        "E211",
        &["r.toml:21:1", "names no joint to follow"],
    ),
    (
        "expression of an unknown joint",
        "[[couple]]\njoint = \"b\"\nexpression = \"sin(q.aa)\"\n",
        "E231",
        &["r.toml:21:1", "\"aa\"", "did you mean \"a\"?"],
    ),
    (
        "expression of itself",
        "[[couple]]\njoint = \"b\"\nexpression = \"q.b*q.a\"\n",
        "E230",
        &["r.toml:21:1", "circle: \"b\" from \"b\""],
    ),
    (
        "expression with an unknown function",
        "[[couple]]\njoint = \"b\"\nexpression = \"1 + tan(q.a)\"\n",
        "E105",
        &["r.toml:21:19", "\"tan\"", "sin, cos, atan2 and sqrt"],
    ),
    (
        "expression that ends too early",
        "[[couple]]\njoint = \"b\"\nexpression = \"sin(q.a\"\n",
        "E105",
        &["r.toml:21:22", "the end", "expected )"],
    ),
    (
        "expression of no kind",
        "[[couple]]\njoint = \"b\"\nexpression = 3\n",
        "E131",
        &["r.toml:21:1", "expression must be a string"],
    ),
    (
        "couple of no kind",
        "couple = 3\n",
        "E130",
        &["r.toml:19:1", "couple"],
    ),
];
