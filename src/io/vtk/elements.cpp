// SPDX-License-Identifier: Apache-2.0
// XML files that are no datasets: their elements, one by one.
#include "common.hpp"

#include <climits>

#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkXMLParser.h>

#include <tetcast/dataset.h>

namespace {

class Elements : public vtkXMLParser {
public:
  static Elements *New() { VTK_STANDARD_NEW_BODY(Elements); }

  TetcastXmlElement *element = nullptr;
  void *user = nullptr;

private:
  void StartElement(const char *name, const char **attributes) override { element(user, depth_++, name, attributes); }
  void EndElement(const char *) override { --depth_; }
  void CharacterDataHandler(const char *, int) override {}

  int depth_ = 0;
};

} // namespace

TetcastStatus tetcast_xml_read(TetcastContext *context, const char *path, TetcastXmlElement *element, void *user) {
  if (!context || !path || !element)
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_xml_read: context, path and element must not be NULL");
  return tcv::fence(context, path, [&] {
    const std::string text = tcv::file_contents(path);
    if (text.size() > INT_MAX)
      tcv::fail(TETCAST_ERROR_DATA, "%s: too large for what it should be", path);
    vtkNew<Elements> parser;
    parser->element = element;
    parser->user = user;
    tcv::captured(context, path, [&] { return parser->Parse(text.c_str(), static_cast<unsigned>(text.size())); });
  });
}
