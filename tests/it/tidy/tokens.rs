//! The tokens of a Rust file, as far as its imports need them: names, `::` and single signs; no comments, no literals.

/// Returns the tokens of a text.
pub fn tokenise(text: &str) -> Vec<String> {
    let signs: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(&sign) = signs.get(at) {
        let next = signs.get(at + 1).copied();
        match (sign, next) {
            ('/', Some('/')) => at = end_of_line(&signs, at),
            ('/', Some('*')) => at = end_of_block(&signs, at),
            ('r', Some('"' | '#')) if is_raw_string(&signs, at) => at = end_of_raw_string(&signs, at),
            ('"', _) => at = end_of_quoted(&signs, at, '"'),
            // A character, not a lifetime.
            ('\'', Some('\\')) => at = end_of_quoted(&signs, at, '\''),
            ('\'', Some(_)) if signs.get(at + 2) == Some(&'\'') => at += 3,
            (':', Some(':')) => {
                tokens.push("::".to_owned());
                at += 2;
            }
            _ if sign.is_alphanumeric() || sign == '_' => {
                let end = (at..signs.len()).find(|&end| !(signs[end].is_alphanumeric() || signs[end] == '_'));
                let end = end.unwrap_or(signs.len());
                tokens.push(signs[at..end].iter().collect());
                at = end;
            }
            _ => {
                if !sign.is_whitespace() {
                    tokens.push(sign.to_string());
                }
                at += 1;
            }
        }
    }
    tokens
}

/// Returns where the item or the attribute that begins here ends: after its `;`, or after its brackets.
pub fn skip_enclosed(tokens: &[String], mut at: usize, [open, close]: [&str; 2]) -> usize {
    let mut depth = 0;
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token.as_str() {
            token if token == open => depth += 1,
            token if token == close => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            ";" if depth == 0 => break,
            _ => {}
        }
    }
    at
}

fn end_of_line(signs: &[char], at: usize) -> usize {
    (at..signs.len()).find(|&end| signs[end] == '\n').unwrap_or(signs.len())
}

fn end_of_block(signs: &[char], at: usize) -> usize {
    (at + 2..signs.len())
        .find(|&end| signs[end] == '*' && signs.get(end + 1) == Some(&'/'))
        .map_or(signs.len(), |end| end + 2)
}

fn end_of_quoted(signs: &[char], at: usize, quote: char) -> usize {
    let mut end = at + 1;
    while let Some(&sign) = signs.get(end) {
        end += if sign == '\\' { 2 } else { 1 };
        if sign == quote {
            break;
        }
    }
    end
}

fn hashes(signs: &[char], at: usize) -> usize {
    signs[at..].iter().take_while(|&&sign| sign == '#').count()
}

fn is_raw_string(signs: &[char], at: usize) -> bool {
    let is_inside_a_name = at > 0 && (signs[at - 1].is_alphanumeric() && signs[at - 1] != 'b');
    !is_inside_a_name && signs.get(at + 1 + hashes(signs, at + 1)) == Some(&'"')
}

fn end_of_raw_string(signs: &[char], at: usize) -> usize {
    let count = hashes(signs, at + 1);
    let begin = at + 2 + count;
    (begin..signs.len())
        .find(|&end| signs[end] == '"' && hashes(signs, end + 1) >= count)
        .map_or(signs.len(), |end| end + 1 + count)
}
