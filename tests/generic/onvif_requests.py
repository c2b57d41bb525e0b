#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""onvif_requests.py PROGRAM: the ONVIF requests that PROGRAM prints against the schemas in ONVIF's published WSDL files.

They are looked for in CERBERUS_ONVIF, else in ../shared/onvif beside the checkout. Needs xmllint. Skipped (77) without.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
ONVIF = pathlib.Path(os.environ.get('CERBERUS_ONVIF', TOP.parent / 'shared' / 'onvif'))
SERVICES = {
    'http://www.onvif.org/ver10/device/wsdl': 'ver10/device/wsdl/devicemgmt.wsdl',
    'http://www.onvif.org/ver10/media/wsdl': 'ver10/media/wsdl/media.wsdl',
    'http://www.onvif.org/ver20/ptz/wsdl': 'ver20/ptz/wsdl/ptz.wsdl',
}
# What onvif.xsd takes from other standards, as far as no request uses it.
ANY = '<xs:sequence><xs:any processContents="skip" minOccurs="0" maxOccurs="unbounded"/></xs:sequence>'
OTHERS = {
    'https://www.w3.org/2005/05/xmlmime': ('http://www.w3.org/2005/05/xmlmime',
                                           '<xs:attribute name="contentType" type="xs:string"/>'),
    'https://www.w3.org/2003/05/soap-envelope': (
        'http://www.w3.org/2003/05/soap-envelope',
        f'<xs:complexType name="Envelope">{ANY}</xs:complexType><xs:complexType name="Fault">{ANY}</xs:complexType>'),
    'https://www.w3.org/2004/08/xop/include': (
        'http://www.w3.org/2004/08/xop/include', f'<xs:element name="Include"><xs:complexType>{ANY}</xs:complexType></xs:element>'),
    'http://docs.oasis-open.org/wsn/b-2.xsd': (
        'http://docs.oasis-open.org/wsn/b-2',
        f'<xs:complexType name="FilterType">{ANY}</xs:complexType>'
        f'<xs:complexType name="NotificationMessageHolderType">{ANY}</xs:complexType>'),
}


def prepare(folder):
    """The schemas as files of their own, each import a file."""
    stubs = {}
    for number, (place, (space, content)) in enumerate(OTHERS.items()):
        stub = folder / f'other{number}.xsd'
        stub.write_text(f'<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" targetNamespace="{space}" '
                        f'xmlns="{space}" elementFormDefault="qualified">{content}</xs:schema>')
        stubs[place] = stub
    for name in ('onvif.xsd', 'common.xsd'):
        text = (ONVIF / 'ver10/schema' / name).read_text(encoding='utf-8')
        for place, stub in stubs.items():
            text = text.replace(f'schemaLocation="{place}"', f'schemaLocation="{stub}"')
        # Without the extension points, where any element would pass (and some of which libxml2 takes for ambiguous).
        text = re.sub(r'<xs:any(Attribute)?\b[^>]*/>', '', text)
        (folder / name).write_text(text, encoding='utf-8')
    schemas = {}
    for number, (space, path) in enumerate(SERVICES.items()):
        text = (ONVIF / path).read_text(encoding='utf-8')
        found = re.search(r'<xs:schema .*?</xs:schema>', text, re.S).group(0)
        # Prefixes that the file declares around it.
        for prefix, uri in re.findall(r'xmlns:(\w+)="([^"]+)"', text[:text.index('<xs:schema')]):
            if f'xmlns:{prefix}=' not in found[:found.index('>')]:
                found = found.replace('<xs:schema ', f'<xs:schema xmlns:{prefix}="{uri}" ', 1)
        found = re.sub(r'schemaLocation="[^"]*onvif\.xsd"', f'schemaLocation="{folder / "onvif.xsd"}"', found)
        schemas[space] = folder / f'service{number}.xsd'
        schemas[space].write_text(found, encoding='utf-8')
    return schemas


def valid(schema, document):
    return subprocess.run(['xmllint', '--nonet', '--noout', '--schema', str(schema), str(document)],
                          capture_output=True, text=True, check=False)


def main():
    if not (ONVIF / 'ver20/ptz/wsdl/ptz.wsdl').exists() or not shutil.which('xmllint'):
        print(f'skipped: no WSDL files in {ONVIF} (CERBERUS_ONVIF names their folder), or no xmllint')
        return 77
    bodies = subprocess.run([sys.argv[1]], capture_output=True, text=True, check=True).stdout.splitlines()
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        schemas = prepare(folder)
        document = folder / 'request.xml'
        for body in bodies:
            schema = schemas[re.search(r'xmlns="([^"]+)"', body).group(1)]
            document.write_text(body, encoding='utf-8')
            said = valid(schema, document)
            if said.returncode:
                print(body, said.stderr, sep='\n')
                wrong += 1
        # The schemas refuse something at all.
        document.write_text(bodies[-1].replace('ProfileToken', 'Token'), encoding='utf-8')
        if valid(schemas['http://www.onvif.org/ver20/ptz/wsdl'], document).returncode == 0:
            print('the schema takes an unknown element')
            wrong += 1
    print(f'{len(bodies)} requests, {wrong} wrong')
    return 1 if wrong or len(bodies) < 10 else 0


sys.exit(main())
