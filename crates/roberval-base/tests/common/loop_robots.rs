//! Robots with loops as texts.

/// Gravity in the plane of planar loops, whose axes are along z.
pub const IN_PLANE: &str = "[0, -9.81, 0]";
/// Gravity along the axes.
pub const NORMAL: &str = "[0, 0, -9.81]";

/// Ground 1, crank 0.3, coupler 0.9, rocker 0.7.
pub fn four_bar(gravity: &str) -> String {
    format!(
        "name = \"four-bar\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.3, r = 0, active = false }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 1, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"2\", \"3\"]\nat = [[0.9, 0, 0], [0.7, 0, 0]]\ncut = \"revolute\"\n"
    )
}

/// Ground 0.8, cranks 0.4, couplers 0.6.
pub fn five_bar(gravity: &str) -> String {
    format!(
        "name = \"five-bar\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.4, r = 0, active = false }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 0.8, r = 0 }},\n\
         {{ name = \"4\", alpha = 0, d = 0.4, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"2\", \"4\"]\nat = [[0.6, 0, 0], [0.6, 0, 0]]\ncut = \"revolute\"\n"
    )
}
