#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace phyxel::test {

/// An element of an XML document, as far as the files that are tested need it: no text, no comments.
struct XmlElement {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::vector<XmlElement> children;

    const XmlElement& child(std::string_view wanted) const {
        for (const XmlElement& c : children)
            if (c.name == wanted) return c;
        throw std::runtime_error("no <" + std::string(wanted) + "> in <" + name + ">");
    }
};

/// Parses one element from `at` on; stops after its end. Text between elements, also binary, stops it: the parser
/// returns the elements still open as if they ended there, with `at` at that text.
class LittleXml {
public:
    explicit LittleXml(std::string_view text) : text_(text) {}

    XmlElement parse() {
        skip_blanks();
        if (text_.substr(at_, 2) == "<?") at_ = text_.find("?>", at_) + 2;
        skip_blanks();
        return element();
    }
    std::size_t position() const { return at_; }

private:
    void skip_blanks() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
    }
    void expect(std::string_view token) {
        if (text_.substr(at_, token.size()) != token)
            throw std::runtime_error("expected " + std::string(token) + " at byte " + std::to_string(at_));
        at_ += token.size();
    }
    std::string name() {
        const std::size_t begin = at_;
        while (at_ < text_.size() && std::string_view(" =/>\n").find(text_[at_]) == std::string_view::npos) ++at_;
        return std::string(text_.substr(begin, at_ - begin));
    }
    static std::string unescaped(std::string_view text) {
        std::string result;
        const std::map<std::string, char> entities = {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}};
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '<') throw std::runtime_error("< in an attribute");
            if (text[i] != '&') {
                result += text[i];
                continue;
            }
            const std::size_t end = text.find(';', i);
            result += entities.at(std::string(text.substr(i + 1, end - i - 1)));
            i = end;
        }
        return result;
    }

    XmlElement element() {
        XmlElement e;
        expect("<");
        e.name = name();
        for (skip_blanks(); text_.at(at_) != '>' && text_.at(at_) != '/'; skip_blanks()) {
            const std::string key = name();
            expect("=\"");
            const std::size_t end = text_.find('"', at_);
            e.attributes[key] = unescaped(text_.substr(at_, end - at_));
            at_ = end + 1;
        }
        if (text_[at_] == '/') return expect("/>"), e;
        expect(">");
        for (skip_blanks(); at_ < text_.size() && text_[at_] == '<'; skip_blanks()) {
            if (text_.substr(at_, 2) == "</") return expect("</"), expect(e.name), expect(">"), e;
            e.children.push_back(element());
        }
        return e;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace phyxel::test
